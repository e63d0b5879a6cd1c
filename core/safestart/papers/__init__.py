"""Figures printed in the papers, to be shown beside ours."""
