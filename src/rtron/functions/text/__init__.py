"""Key information (paper A.1): names, descriptions and READMEs, as words."""
