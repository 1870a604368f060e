"""An export as files: the verdict on what is written, sidecars, digests, and verification of a folder."""
