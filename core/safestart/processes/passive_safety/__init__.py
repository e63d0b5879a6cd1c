"""The passive-safety process: is the switched rendezvous safe, and until when can it be aborted?"""
