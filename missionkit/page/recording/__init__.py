"""A recorded flight as the page plays it back."""
