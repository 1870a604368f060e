"""Speed of thermicon beside other programs that compute the same, as a page of figures."""
