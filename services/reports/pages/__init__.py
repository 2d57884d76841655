"""What a report shows on a page: tables, figures, and the page itself."""
