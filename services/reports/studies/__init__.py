"""What the notebooks ask, and how the answers are drawn: they hold no function of their own."""
