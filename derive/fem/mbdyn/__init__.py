"""Parts from the modal data of MBDyn."""
