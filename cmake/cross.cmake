# What the toolchain files share: libraries and headers of the machine that builds are not found. RubbleCross.cmake brings
# those that are headers or sources.
set(CMAKE_FIND_ROOT_PATH /usr/${rubble_cross})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_LIBDIR} /usr/${rubble_cross}/lib/pkgconfig)
