# Recipe for Conan 2: conan create .
from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout


class PcsConan(ConanFile):
    name = "pcs"
    version = "0.1.0"
    description = "Header-only C++17 library for the structure of point clouds, built on CGAL"
    license = "BSL-1.0"
    package_type = "header-library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"with_tbb": [True, False], "with_zlib": [True, False]}
    default_options = {"with_tbb": True, "with_zlib": True}
    exports_sources = "CMakeLists.txt", "LICENSE", "cmake/*", "include/*"

    def requirements(self):
        self.requires("cgal/[>=5.5]", transitive_headers=True)
        self.requires("eigen/[>=3.4 <4]", transitive_headers=True)
        self.requires("boost/[>=1.74]", transitive_headers=True)
        self.requires("nanoflann/[>=1.4]", transitive_headers=True)
        if self.options.with_tbb:
            self.requires("onetbb/[>=2021]", transitive_headers=True)
        if self.options.with_zlib:
            self.requires("zlib/[>=1.2]", transitive_headers=True)

    def validate(self):
        check_min_cppstd(self, 17)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["PCS_WITH_TBB"] = bool(self.options.with_tbb)
        toolchain.cache_variables["PCS_WITH_ZLIB"] = bool(self.options.with_zlib)
        toolchain.cache_variables["PCS_WITH_LASZIP"] = False
        toolchain.cache_variables["PCS_BUILD_TESTS"] = False
        toolchain.cache_variables["PCS_BUILD_EXAMPLES"] = False
        toolchain.generate()

    def package(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.install()

    def package_id(self):
        self.info.settings.clear()

    def package_info(self):
        # pcsConfig.cmake of the package finds the dependencies itself
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs = ["share/cmake/pcs"]
        self.cpp_info.bindirs = []
        self.cpp_info.libdirs = []
