"""Figures printed in the papers, shown beside ours."""
