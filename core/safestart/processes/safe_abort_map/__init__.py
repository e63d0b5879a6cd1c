"""The safe-abort-map process: from which starts may the switched rendezvous be aborted, and until when?"""
