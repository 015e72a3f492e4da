# Filled by the install and export rules.
