"""The inclusion-chain process: are the safe-start sets nested as paper 000, eq. (12), says?"""
