// A program whose client of the library is a shared library: stream.cpp with its main() under another name.
int client_main();
int main() { return client_main(); }
