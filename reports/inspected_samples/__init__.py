"""What `tethertest inspect` says of sample logs."""
