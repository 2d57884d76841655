"""Reports: notebooks that read verdicts and draw; one question each, exported as one HTML file."""
