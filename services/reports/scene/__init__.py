"""What is drawn of a kitchen, its robots and their motions, in a page and on paper."""
