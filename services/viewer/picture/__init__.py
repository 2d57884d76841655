"""What is drawn, as values; nothing here knows a browser, an oracle or a clock."""
