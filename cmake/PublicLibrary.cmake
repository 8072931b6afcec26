# The library for other programs: the objects of every room but cli/ in one file, with the headers of include/camber/,
# a CMake package, a pkg-config file, and the find module for OpenVDB, which Debian's package comes without.
set(rooms base nc machine kinematics feedmodel repath removal deflection dynamics workpiece motion checks simulate inspect plausibility posture adapt copymill compensate distribute plan calib report api)
list(TRANSFORM rooms REPLACE "(.+)" "$<TARGET_OBJECTS:camber_\\1>" OUTPUT_VARIABLE objects)
add_library(camber_library ${objects})
add_library(camber::camber ALIAS camber_library)
set_target_properties(camber_library PROPERTIES OUTPUT_NAME camber EXPORT_NAME camber LINKER_LANGUAGE CXX
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
target_compile_features(camber_library PUBLIC cxx_std_20)
file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/camber/*.h)
target_sources(camber_library PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${headers})
target_link_libraries(camber_library PRIVATE OpenVDB::openvdb TBB::tbb Ceres::ceres LibZip::zip pugixml::pugixml
  SQLite::SQLite3 ZLIB::ZLIB fmt::fmt ${CAMBER_OPENCASCADE_LIBRARIES})
if(BUILD_SHARED_LIBS)
  # Only the public names are shown, and those of OpenVDB's templates, whose static members libopenvdb shares.
  target_link_options(camber_library PRIVATE -fuse-ld=lld
    -Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/camber.map)
  if(NOT CAMBER_SANITIZE) # the sanitizers' functions are in the executable
    target_link_options(camber_library PRIVATE -Wl,-z,defs)
  endif()
  set_target_properties(camber_library PROPERTIES LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/camber.map)
endif()
if(CAMBER_SANITIZE)
  target_link_options(camber_library PUBLIC -fsanitize=${CAMBER_SANITIZE})
endif()

include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/camber)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/camberConfig.cmake.in
  ${PROJECT_BINARY_DIR}/cmake/camberConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cmake/camberConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
file(RELATIVE_PATH prefix_from_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(${PROJECT_SOURCE_DIR}/cmake/camber.pc.in ${PROJECT_BINARY_DIR}/cmake/camber.pc @ONLY)

install(TARGETS camber_library EXPORT camberTargets FILE_SET HEADERS)
install(EXPORT camberTargets NAMESPACE camber:: DESTINATION ${package})
install(FILES ${PROJECT_BINARY_DIR}/cmake/camberConfig.cmake ${PROJECT_BINARY_DIR}/cmake/camberConfigVersion.cmake
  DESTINATION ${package})
install(FILES ${PROJECT_SOURCE_DIR}/cmake/FindOpenVDB.cmake ${PROJECT_SOURCE_DIR}/cmake/FindLibZip.cmake
  DESTINATION ${package}/modules)
install(FILES ${PROJECT_BINARY_DIR}/cmake/camber.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
