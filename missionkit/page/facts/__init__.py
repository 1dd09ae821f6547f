"""What the page shows, as plain values that JSON can say."""
