"""Which sources make which target, as a CMakeLists.txt decides."""

import pytest
from file_tree import write
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from workspace_tree import evaluate_cmake, sources

from rtron.sources.workspace.cmake.evaluator import evaluate_package
from rtron.sources.workspace.package_contents import TargetKind
from rtron.sources.workspace.package_files import list_files

SOURCES_OF_X = [
    ("add_executable(x a.cpp b.cpp)", "a b"),
    ("add_executable(x a b.cpp)", "a b"),
    ("set(S a.cpp b.cpp)\nadd_executable(x ${S})", "a b"),
    ("set(S a.cpp)\nlist(APPEND S c.cpp)\nadd_executable(x ${S})", "a c"),
    ("set(S a.cpp b.cpp)\nlist(REMOVE_ITEM S a.cpp)\nadd_executable(x ${S})", "b"),
    ("set(N S)\nset(S a.cpp)\nadd_executable(x ${${N}})", "a"),
    ("set(n_S a.cpp)\nset(n n)\nadd_executable(x ${${n}_S})", "a"),
    ("file(GLOB S *.cpp)\nadd_executable(x ${S})", "a b c"),
    ("file(GLOB S RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} [ab].cpp)\nadd_executable(x ${S})", "a b"),
    ("file(GLOB S ../*.cpp /etc/*)\nadd_executable(x a.cpp ${S})", "a"),
    ("file(GLOB_RECURSE S *.cpp)\nadd_executable(x ${S})", "a b c sub/d"),
    ("file(GLOB_RECURSE S sub/*.cpp)\nadd_executable(x ${S})", "sub/d"),
    ("file(GLOB_RECURSE S LIST_DIRECTORIES FALSE *.cpp)\nadd_executable(x ${S})", "a b c sub/d"),
    ("file(GLOB S s*/*.cpp)\nadd_executable(x ${S})", "sub/d"),
    ("aux_source_directory(sub S)\nadd_executable(x ${S})", "sub/d"),
    ("foreach(n a b)\nlist(APPEND S ${n}.cpp)\nendforeach()\nadd_executable(x ${S})", "a b"),
    (("set(L a b)\nforeach(n IN LISTS L ITEMS c)\nlist(APPEND S ${n}.cpp)\nendforeach()\n"
     "add_executable(x ${S})"), "a b c"),
    ("if(WIN32)\nadd_executable(x a.cpp)\nelse()\nadd_executable(x b.cpp)\nendif()", "b"),
    (("if(NOT WIN32 AND UNIX)\nset(S a.cpp)\nelseif(WITH)\nset(S b.cpp)\nendif()\n"
     "add_executable(x ${S})"), "a"),
    ("if(CUDA_FOUND)\nset(S a.cpp)\nelse()\nset(S b.cpp)\nendif()\nadd_executable(x ${S})", "a b"),
    ("set(S c.cpp)\nif(WITH)\nset(S a.cpp)\nendif()\nadd_executable(x ${S})", "c a"),
    (('option(WITH "" OFF)\nif(WITH)\nset(S a.cpp)\nelse()\nset(S b.cpp)\nendif()\n'
     "add_executable(x ${S})"), "b"),
    (('if("${V}" MATCHES "k")\nset(S a.cpp)\nelse()\nset(S b.cpp)\nendif()\n'
     "add_executable(x ${S})"), "a b"),
    (("set(V 1.9)\nif(V VERSION_LESS 1.10)\nset(S a.cpp)\nelse()\nset(S b.cpp)\nendif()\n"
     "add_executable(x ${S})"), "a"),
    ("macro(m n s)\nadd_library(${n} ${ARGV2} ${s})\nendmacro()\nm(x a.cpp)\nm(y a.cpp SHARED)",
     "a"),
    ("macro(m n)\nset(S ${n} ${ARGN})\nendmacro()\nm(a.cpp b.cpp)\nadd_executable(x ${S})", "a b"),
    ("function(f n)\nset(S ${n})\nendfunction()\nset(S b.cpp)\nf(a.cpp)\nadd_executable(x ${S})",
     "b"),
    ("function(f)\nset(S a.cpp PARENT_SCOPE)\nendfunction()\nf()\nadd_executable(x ${S})", "a"),
    ("function(make_${PROJECT_NAME} n)\nadd_executable(${n} a.cpp)\nendfunction()\nmake_pkg(x)",
     "a"),
    (('function(f n)\ncmake_parse_arguments(A "STRICT" "NAME" "FILES;LIBS" ${ARGN})\n'
     "add_executable(${A_NAME} ${A_FILES})\nendfunction()\n"
     "f(y STRICT FILES a.cpp c.cpp NAME x LIBS ${foo_TARGETS} foo::foo)"), "a c"),
    (('function(f)\ncmake_parse_arguments(PARSE_ARGV 1 A "" "NAME" "FILES")\n'
     "add_executable(x ${A_UNPARSED_ARGUMENTS} ${A_FILES})\nendfunction()\n"
     "f(c.cpp NAME y b.cpp FILES a.cpp)"), "b a"),
    (('function(f)\ncmake_parse_arguments(A "FAST" "" "" ${ARGN})\nif(A_FAST)\nset(S a.cpp)\n'
     "else()\nset(S b.cpp)\nendif()\nadd_executable(x ${S})\nendfunction()\nf()"), "b"),
    ("add_executable(x)\ntarget_sources(x PRIVATE a.cpp)", "a"),
    ("cuda_add_executable(x a.cpp)", "a"),
    ("rosbuild_add_executable(x a.cpp)", "a"),
    ("cs_add_executable(x a.cpp)", "a"),
    ("add_rostest_gtest(x test/x.test a.cpp)", "a"),
    ("qt5_wrap_cpp(M a.hpp)\nadd_executable(x a.cpp ${M})", "a"),
    ("add_executable(x a.cpp)\nreturn()\nadd_executable(x b.cpp)", "a"),
    ("if(WITH)\nreturn()\nendif()\nadd_executable(x a.cpp)", "a"),
    (('option(SUPER "all" ON)\nif(SUPER)\nExternalProject_Add(ep DEPENDS other SOURCE_DIR\n'
      "${PROJECT_SOURCE_DIR} CMAKE_ARGS -DSUPER:BOOL=OFF -DS=a.cpp)\nreturn()\nendif()\n"
      "add_executable(x ${S})"), "a"),
    (('option(SUPER "all" ON)\nif(SUPER)\nExternalProject_Add(ep SOURCE_DIR\n'
      "${CMAKE_CURRENT_LIST_DIR}/sub/.. CMAKE_CACHE_ARGS -DSUPER:BOOL=OFF)\nreturn()\nendif()\n"
      "add_executable(x a.cpp)"), "a"),
    ("ExternalProject_Add(ep SOURCE_DIR ${PROJECT_SOURCE_DIR})\nadd_executable(x a.cpp)", "a"),
    (("ExternalProject_Add(ep SOURCE_DIR /else CMAKE_ARGS -DX=1)\nif(X)\nset(S b.cpp)\nendif()\n"
      "add_executable(x a.cpp)"), "a"),
    ("set(L x b a)\nlist(GET L -1 n)\nadd_executable(x ${n})", "a"),
    ("set(L a cpp)\nlist(JOIN L . S)\nadd_executable(x ${S})", "a"),
    ("set(L c.cpp b.cpp a.cpp)\nlist(SUBLIST L 1 2 S)\nadd_executable(x ${S})", "b a"),
    ("set(L c.cpp b.cpp)\nlist(POP_FRONT L f)\nadd_executable(x ${L} ${f})", "b c"),
    ("set(L c.cpp b.cpp)\nlist(REMOVE_AT L 0)\nadd_executable(x ${L})", "b"),
    ('file(GLOB S *.cpp)\nlist(FILTER S EXCLUDE REGEX ".*/b\\\\.cpp$")\nadd_executable(x ${S})',
     "a c"),
    ('set(L a.cc)\nlist(TRANSFORM L REPLACE "\\\\.cc$" ".cpp")\nadd_executable(x ${L})', "a"),
    ("set(L a b)\nlist(TRANSFORM L APPEND .cpp)\nadd_executable(x ${L})", "a b"),
    ('string(REGEX REPLACE "\\\\.[^.]*$" "" n x.cpp)\nadd_executable(${n} a.cpp)', "a"),
    ('string(REGEX REPLACE "^my_" "" n my_x)\nadd_executable(${n} a.cpp)', "a"),
    ("string(JOIN . n a cpp)\nadd_executable(x ${n})", "a"),
    ("set(n x.a.cpp)\nget_filename_component(s ${n} NAME_WLE)\nadd_executable(x a ${s})", "a"),
    ("set(p sub/x.cpp)\ncmake_path(GET p STEM n)\nadd_executable(${n} a.cpp)", "a"),
    ("foreach(n s IN ZIP_LISTS N S)\nendforeach()\nadd_executable(x a.cpp)", "a"),
    (("set(N x y)\nset(S a b)\nforeach(n s IN ZIP_LISTS N S)\nadd_executable(${n} ${s}.cpp)\n"
     "endforeach()"), "a"),
    (("set(N x y)\nset(S a b)\nforeach(i IN ZIP_LISTS N S)\nadd_executable(${i_0} ${i_1}.cpp)\n"
     "endforeach()"), "a"),
    (('if("${PROJECT_NAME}.x" MATCHES "^p.*\\\\.x$")\nset(S a.cpp)\nelse()\nset(S b.cpp)\nendif()\n'
     "add_executable(x ${S})"), "a"),
    (("file(GLOB L RELATIVE ${PROJECT_SOURCE_DIR} *)\nforeach(n ${L})\n"
     "if(n STREQUAL sub)\nset(S ${n}/d.cpp)\nendif()\nendforeach()\nadd_executable(x ${S})"),
     "sub/d"),
    ("add_executable(x $<$<BOOL:${WITH}>:a.cpp> $<$<CONFIG:Debug>:b.cpp>)", "a b"),
    ("cmake_language(CALL add_executable x a.cpp)", "a"),
    ("catkin_add_gtest(x a.cpp WORKING_DIRECTORY test TIMEOUT 9)", "a"),
    ("add_executable(x a.cpp)\nament_add_gtest(test_x b.cpp TIMEOUT 60)", "a"),
    ("pybind11_add_module(x MODULE a.cpp NO_EXTRAS)", "a"),
    ("set(i a.cpp)\nforeach(i b.cpp c.cpp)\nendforeach()\nadd_executable(x ${i})", "a"),
    (("foreach(i a b c)\nif(i STREQUAL b)\nbreak()\nendif()\nset(S ${i}.cpp)\nendforeach()\n"
     "add_executable(x ${S})"), "a"),
    (("foreach(i a b)\nif(i STREQUAL b)\ncontinue()\nendif()\nset(S ${i}.cpp)\nendforeach()\n"
     "add_executable(x ${S})"), "a"),
    ("macro(m n)\nset(n b)\nadd_executable(x ${n}.cpp)\nendmacro()\nm(a)", "a"),
    ("get_filename_component(d a.cpp DIRECTORY)\nadd_executable(x a${d}.cpp)", "a"),
    ("string(TOLOWER A.CPP S)\nadd_executable(x ${S})", "a"),
    ("add_executable(${PROJECT_NAME} a.cpp)\nadd_executable(x b.cpp)", "b"),
    ("project(q)\nadd_executable(${PROJECT_NAME}x a.cpp)\nadd_executable(x b.cpp)", "b"),
    ("add_executable(x ${CMAKE_CURRENT_SOURCE_DIR}/sub/../a.cpp)", "a"),
]  # fmt: skip


@pytest.mark.parametrize(("cmake", "expected"), SOURCES_OF_X)
def test_sources(tmp_path, cmake, expected):
    contents = evaluate_cmake(tmp_path, cmake, "a.cpp b.cpp c.cpp sub/d.cpp")
    assert sources(contents)["x"] == [f"{name}.cpp" for name in expected.split()]
    assert not contents.unresolved


def test_a_target_has_kind_links_definitions_and_place(tmp_path):
    contents = evaluate_cmake(
        tmp_path,
        "add_definitions(-DALL=1 -Wall)\nfind_package(catkin REQUIRED COMPONENTS roscpp tf)\n"
        "add_library(core a.cpp)\nset_target_properties(core PROPERTIES OUTPUT_NAME other)\n"
        "target_compile_definitions(core PRIVATE ONE -DTWO)\n"
        "target_link_libraries(core PUBLIC base ${catkin_LIBRARIES})",
    )
    (core,) = contents.targets
    assert (core.kind, core.output_name) == (TargetKind.LIBRARY, "other")
    assert core.links == ("base", "roscpp", "tf")
    assert core.definitions == ("ONE", "TWO", "ALL=1")
    assert contents.target("other", TargetKind.LIBRARY) is core
    assert contents.target("other", TargetKind.EXECUTABLE) is None


@pytest.mark.parametrize(
    "written",
    ["$<BUILD_INTERFACE:core>", "$<$<BOOL:1>:p::core>", "$<$<NOT:$<BOOL:0>>:core>", "core"],
)
def test_links_stand_in_generator_expressions_too(tmp_path, written):
    cmake = f"add_library(core a.cpp)\nadd_executable(x b.cpp)\ntarget_link_libraries(x {written})"
    *_, target = evaluate_cmake(tmp_path, cmake).targets
    assert {"core", "p::core"} & set(target.links)


def test_subfolders_and_included_files_are_carried_out(tmp_path):
    write(tmp_path / "sub", {"CMakeLists.txt": "add_library(s d.cpp)\nset(S a.cpp)", "d.cpp": ""})
    write(tmp_path / "cmake", {"m.cmake": "set(T b.cpp)"})
    cmake = "add_subdirectory(sub)\ninclude(cmake/m.cmake)\nadd_executable(x c.cpp ${T})"
    assert sources(evaluate_cmake(tmp_path, cmake)) == {"s": ["sub/d.cpp"], "x": ["c.cpp", "b.cpp"]}


def test_a_superbuild_builds_folders_of_the_package(tmp_path):
    write(tmp_path / "sub", {"CMakeLists.txt": "add_executable(x ${S})", "d.cpp": ""})
    cmake = "ExternalProject_Add(ep SOURCE_DIR ${PROJECT_SOURCE_DIR}/sub CMAKE_ARGS -DS=d.cpp)"
    assert sources(evaluate_cmake(tmp_path, cmake)) == {"x": ["sub/d.cpp"]}


def test_modules_are_found_by_the_module_path(tmp_path):
    write(tmp_path / "cmake", {"m.cmake": "add_executable(x a.cpp)"})
    cmake = "list(APPEND CMAKE_MODULE_PATH ${PROJECT_SOURCE_DIR}/cmake)\ninclude(m)\ninclude(no)"
    assert sources(evaluate_cmake(tmp_path, cmake)) == {"x": ["a.cpp"]}


def test_all_folders_below_one_are_listed_where_a_file_asks_for_them(tmp_path):
    write(tmp_path, {"include/a/deep/x.h": "", "include/b/y.h": "", "other/z.h": ""})
    cmake = (
        "function(all_below)\n"
        "file(GLOB_RECURSE L LIST_DIRECTORIES {} ${{PROJECT_SOURCE_DIR}}/include/*)\n"
        "foreach(D ${{L}})\nif(IS_DIRECTORY ${{D}})\ninclude_directories(${{D}})\nendif()\n"
        "endforeach()\n"
        "endfunction()\nall_below()"
    )
    below = [tmp_path / "include" / name for name in ("a", "b", "a/deep")]
    assert list(evaluate_cmake(tmp_path, cmake.format("TRUE")).include_dirs) == below
    assert evaluate_cmake(tmp_path, cmake.format("FALSE")).include_dirs == ()


def test_include_folders_and_installed_scripts(tmp_path):
    write(tmp_path, {"include/x.h": "", "s.py": ""})
    contents = evaluate_cmake(
        tmp_path,
        "include_directories(BEFORE include ${catkin_INCLUDE_DIRS} /usr/include)\n"
        "install(PROGRAMS s.py RENAME run DESTINATION bin)\n"
        "catkin_install_python(PROGRAMS s.py none.py DESTINATION bin)",
    )
    assert contents.include_dirs == (tmp_path / "include",)
    assert contents.installed_scripts == (("run", tmp_path / "s.py"), ("s.py", tmp_path / "s.py"))


@pytest.mark.parametrize(
    ("cmake", "line", "why"),
    [
        ("add_executable(x a.cpp gone.cpp)", 2, "generated or missing"),
        ("add_subdirectory(gone)", 2, "has no CMakeLists.txt here"),
        ("add_subdirectory(${GONE})", 2, "which folder it is, is not known"),
        ("include(cmake/gone.cmake)", 2, "is not in the package"),
        ("foreach(n ${UNSET})\nadd_executable(${n} a.cpp)\nendforeach()", 2,
         "goes through is not known"),
        (('set(L "")\nexecute_process(COMMAND ls OUTPUT_VARIABLE L)\nforeach(n IN LISTS L)\n'
         "add_executable(${n} a.cpp)\nendforeach()"), 4, "goes through is not known"),
        ('set(L x a.cpp)\nlist(TRANSFORM L REPLACE "(x|y)" z)\nadd_executable(${L})', 4,
         "is not set"),
        ('string(REGEX MATCH "[a-z]+" n x1)\nadd_executable(${n} a.cpp)', 3, "is not set"),
        ("my_node(x a.cpp)", 2, "not known here: what it makes of a.cpp"),
        ("install(PROGRAMS gone.py DESTINATION lib/pkg)", 2, "generated or missing"),
        ("install(PROGRAMS ${UNSET} DESTINATION lib/pkg)", 2, "does not set"),
        ("add_executable(x a.cpp $<$<BOOL:${X}>:gone.cpp>)", 2, "a generator expression"),
        ('cmake_language(EVAL CODE "add_executable(x a.cpp)")', 2, "is not carried out"),
        ("add_library(l a.cpp)\nrclcpp_components_register_node(l PLUGIN ${UNSET})", 3,
         "is not set"),
        ("add_executable(x a.cpp ${UNSET})", 2, "does not set"),
        ("\nadd_executable(${UNSET}_x a.cpp)", 3, "is not set"),
        ('add_executable(x a.cpp)\nset(y "z', 3, "does not end"),
        ("if(y)", 2, "has no end"),
        ("include(CMakeLists.txt)", 2, "nests more than"),
        ("add_subdirectory(.)", 2, "nests more than"),
        ("macro(m)\nm()\nm()\nendmacro()\nm()", 3, "nests more than"),
        ("set(a x)\nforeach(i RANGE 99)\nset(a ${a}${a})\nendforeach()", 4, "too long"),
        ("foreach(i RANGE 9999)\nforeach(j RANGE 9999)\nset(a b)\nendforeach()\nendforeach()",
         4, "too many steps"),
    ],
)  # fmt: skip
def test_what_is_not_resolved_is_noted_with_its_place(tmp_path, cmake, line, why):
    (note,) = evaluate_cmake(tmp_path, cmake).unresolved
    assert why in note.why
    assert note.evidence[0].line == line


def test_links_out_of_the_package_are_no_files(tmp_path):
    outside = write(tmp_path / "out", {"e.cpp": ""})
    folder = tmp_path / "pkg"
    folder.mkdir()
    (folder / "e.cpp").symlink_to(outside / "e.cpp")
    (folder / "loop").symlink_to(folder)
    contents = evaluate_cmake(folder, "file(GLOB_RECURSE S *.cpp)\nadd_executable(x ${S})")
    assert sources(contents)["x"] == ["a.cpp", "b.cpp", "c.cpp"]


def test_a_large_file_is_noted(tmp_path):
    assert "larger than" in evaluate_cmake(tmp_path, "#" * 2**20).unresolved[0].why


def test_a_package_without_cmake_has_nothing(tmp_path):
    assert evaluate_package("pkg", list_files(tmp_path, ())).targets == ()


WORDS = st.sampled_from(
    [
        *("set(a ${a} b)", "set(${a} c)", "set()", "set(a \0)", "project()", "list(APPEND a a)"),
        *("if(a)", "if(NOT (a AND b STREQUAL c))", "elseif(EXISTS ${a})", "else()", "endif()"),
        *("if()", "if(", '"', "foreach(a b ${a} c)", "foreach()", "endforeach()", "while(a)"),
        *("endwhile()", "macro(m a)", "macro()", "endmacro()", "m(x y)", "function(f)"),
        *("endfunction()", "f(${a})", "return()", "include(${a})", "add_library(a ${a} x.cpp)"),
        *("add_executable()", "file(GLOB a [!] *)", "string(REPLACE b bb a ${a})", "list()"),
        *("set_property(TARGET a PROPERTY)", "install(PROGRAMS RENAME)", "foreach(i RANGE 3 1)"),
    ]
).map("{}\n".format)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.lists(WORDS, max_size=25).map("".join))
def test_any_file_is_evaluated(tmp_path, text):
    assert evaluate_cmake(tmp_path, text).name == "pkg"
