"""What `tethertest analyze` says of the synthetic campaign's lines and events, against its truth."""
