# The pictures of the report page: report/web with three.js and uPlot, bundled by esbuild into one C++ file.
# camber_report_bundle(TARGET) adds that file to the target. The packages are fetched once per build folder (npm ci, as
# package-lock.json says) and the bundle is made again only when report/web changes; neither writes to the source folder.
find_program(NODE node REQUIRED)
find_program(NPM npm REQUIRED)

set(CAMBER_WEB_DIR ${PROJECT_BINARY_DIR}/report/web CACHE INTERNAL "where report/web is bundled")
file(MAKE_DIRECTORY ${CAMBER_WEB_DIR})

function(camber_report_bundle target)
  set(source ${PROJECT_SOURCE_DIR}/report/web)
  set(installed ${CAMBER_WEB_DIR}/node_modules/.package-lock.json)
  add_custom_command(OUTPUT ${installed}
    COMMAND ${CMAKE_COMMAND} -E copy ${source}/package.json ${source}/package-lock.json ${CAMBER_WEB_DIR}
    # playwright-core, which only the tests need, is a development dependency. No package's install script is run.
    COMMAND ${NPM} ci --ignore-scripts --prefer-offline --no-audit --no-fund --loglevel=error $<$<NOT:$<BOOL:${CAMBER_TESTS}>>:--omit=dev>
    COMMAND ${CMAKE_COMMAND} -E touch ${installed}
    WORKING_DIRECTORY ${CAMBER_WEB_DIR}
    DEPENDS ${source}/package.json ${source}/package-lock.json
    COMMENT "Fetching three.js, uPlot and esbuild for the report page"
    COMMAND_EXPAND_LISTS VERBATIM)
  file(GLOB scripts CONFIGURE_DEPENDS ${source}/src/*.js ${source}/src/*.css)
  set(bundle ${CAMBER_WEB_DIR}/report_bundle.cpp)
  add_custom_command(OUTPUT ${bundle}
    COMMAND ${NODE} ${source}/build.mjs ${source}/src ${CAMBER_WEB_DIR} ${bundle}
    DEPENDS ${installed} ${source}/build.mjs ${scripts}
    COMMENT "Bundling the report page's script"
    VERBATIM)
  target_sources(${target} PRIVATE ${bundle})
endfunction()
