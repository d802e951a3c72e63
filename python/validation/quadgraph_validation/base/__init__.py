"""What every room of the validation uses: a record's machine, its files, its folders."""
