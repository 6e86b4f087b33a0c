"""The CMake language, as far as it decides which sources make which executable or library.

Source: CMake's manual, cmake-language(7) and cmake-commands(7).
"""
