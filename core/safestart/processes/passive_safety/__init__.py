"""The passive-safety process: is the switched rendezvous safe, and until when may it be aborted?"""
