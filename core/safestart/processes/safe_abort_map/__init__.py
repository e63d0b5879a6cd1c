"""The safe-abort-map process: from which starts can the switched rendezvous be aborted, and until when?"""
