"""The commit-timeline process: over a span of time, when may a chaser leave its course and start its approach?"""
