"""`sdt whatif` and `sdt codesign`."""
