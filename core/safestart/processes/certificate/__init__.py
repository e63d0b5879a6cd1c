"""The certificate process: closed form on a grid."""
