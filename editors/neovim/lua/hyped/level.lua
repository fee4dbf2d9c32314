-- Levels of worlds that leave their map open: the server knows which files fit, and keeps what was chosen.

local M = {}

--- The client of the language server of a file.
---@param file string
function M.client(file)
  local buffer = vim.fn.bufnr(file)
  return vim.lsp.get_clients({ name = 'hypedc', bufnr = buffer ~= -1 and buffer or nil })[1]
end

--- Asks the server about a file, and passes the answer on with the unit of its columns.
---@param file string
---@param method string
---@param parameters table
---@param done? fun(result: any, encoding: string)
function M.request(file, method, parameters, done)
  local client = M.client(file)
  if not client then
    vim.notify('hypedc: the language server does not run', vim.log.levels.ERROR)
    return
  end
  local about = vim.tbl_extend('error', { textDocument = { uri = vim.uri_from_fname(file) } }, parameters)
  client:request(method, about, function(failure, result)
    if failure then
      vim.notify('hypedc: ' .. failure.message, vim.log.levels.ERROR)
    elseif done then
      done(result, client.offset_encoding)
    end
  end)
end

--- Asks for a level of a world, and passes it on.
---@param file string
---@param world string
---@param done fun(level: table)?
function M.choose(file, world, done)
  M.request(file, 'hypedc/levels', { world = world }, function(found)
    if #found.levels == 0 then
      vim.notify(('hypedc: the world %s needs a level, and there is none beside the program'):format(world), vim.log.levels.WARN)
      return
    end
    local function name(level)
      return level.fits and level.name or ('%s (%s)'):format(level.name, level.why)
    end
    vim.ui.select(found.levels, { prompt = ('Level of %s'):format(world), format_item = name }, function(level)
      if level then
        local chosen = { map = level.map }
        M.request(file, 'hypedc/chooseLevel', { world = world, level = chosen }, function()
          if done then
            done(chosen)
          end
        end)
      end
    end)
  end)
end

--- Runs something with the level of a code lens: `nil` if the world needs none, `'ask'` if none was chosen.
function M.with(file, world, level, run)
  if level == 'ask' then
    M.choose(file, world, run)
  else
    run(level ~= vim.NIL and level or nil)
  end
end

--- The options of the command line for a level.
function M.options(level)
  local options = {}
  for _, name in ipairs({ 'map', 'legend' }) do
    vim.list_extend(options, level and level[name] and { '--' .. name, level[name] } or {})
  end
  vim.list_extend(options, level and level.tile and { '--tile', table.concat(level.tile, 'x') } or {})
  return options
end

return M
