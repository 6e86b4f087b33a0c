"""C++ (C++98 to C++20, C, CUDA): a file's text lowered to the intermediate representation."""

from rtron.sources.code.frontends.cpp.lowering import lower_cpp

__all__ = ["lower_cpp"]
