"""What `tethertest report` recovers from the synthetic campaign, against the truth it was made from."""
