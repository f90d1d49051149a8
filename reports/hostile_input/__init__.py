"""Files and run folders that are made to do harm, and what became of them."""
