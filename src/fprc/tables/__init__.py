"""The paper's tables: from results to tidy data frames, and to pages for readers."""
