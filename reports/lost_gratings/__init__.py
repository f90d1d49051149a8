"""Random interrogator logs with lost, slipped, crossed and false peaks."""
