"""The 3D page: what a verdict is about, drawn. It reads verdicts and draws; it decides nothing."""
