"""Speed beside other libraries, and what more of everything would cost."""
