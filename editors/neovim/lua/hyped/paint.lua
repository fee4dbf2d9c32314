-- Painted maps: the tiles of a world, shaded by what a search and the known ways saw of them. `:HypedPaint` paints, and
-- takes the paint away; `:HypedTile` tells of the tile under the cursor, and asks for a way there.

local level = require('hyped.level')

local M = {}

local namespace = vim.api.nvim_create_namespace('hyped.paint')
-- What was painted: by the URI of the text, a list of { program, painted, space }.
local painted = {}

local function given(value)
  return value ~= nil and value ~= vim.NIL and value or nil
end

--- The highlight of a tile (from 1); none of the inside of walls.
local function highlight(space, index, last)
  if space.onWay[index] then
    return 'HypedPaintWay'
  end
  local first = given(space.first[index])
  if first then
    return 'HypedPaint' .. math.min(4, math.floor(4 * first / (last + 1)) + 1)
  end
  if space.stoodOn[index] then
    return 'HypedPaintStood'
  end
  return #space.kinds[space.kind[index] + 1].tags == 0 and 'HypedPaintUnseen' or nil
end

--- The byte of a column that counts UTF-16 code units.
local function byte(line, column, encoding)
  local ok, found = pcall(vim.str_byteindex, line, encoding, column, false)
  return ok and found or #line
end

local function draw(buffer, space, encoding)
  local last = 1
  for _, first in ipairs(space.first) do
    last = math.max(last, given(first) or 0)
  end
  for row, place in ipairs(space.rows) do
    local line = given(place) and vim.api.nvim_buf_get_lines(buffer, place.line, place.line + 1, false)[1]
    for column = 1, line and space.columns or 0 do
      local from, to = place.columns[column], place.columns[column + 1]
      local group = from and to and highlight(space, (row - 1) * space.columns + column, last)
      if group then
        vim.api.nvim_buf_set_extmark(buffer, namespace, place.line, byte(line, from, encoding), {
          end_col = byte(line, to, encoding),
          hl_group = group,
        })
      end
    end
  end
end

--- Takes all paint away.
function M.clear()
  for uri in pairs(painted) do
    local buffer = vim.uri_to_bufnr(uri)
    if vim.api.nvim_buf_is_loaded(buffer) then
      vim.api.nvim_buf_clear_namespace(buffer, namespace, 0, -1)
    end
  end
  painted = {}
end

--- Paints the maps of a world.
---@param file string
---@param world string
function M.paint(file, world)
  level.request(file, 'hypedc/paint', { world = world }, function(found, encoding)
    M.clear()
    for _, space in ipairs(found.spaces) do
      painted[space.uri] = painted[space.uri] or {}
      table.insert(painted[space.uri], { program = file, painted = found, space = space })
      local buffer = vim.uri_to_bufnr(space.uri)
      if vim.api.nvim_buf_is_loaded(buffer) then
        draw(buffer, space, encoding)
        -- What is painted is about the text as it was: a change takes it away.
        vim.api.nvim_buf_attach(buffer, false, {
          on_lines = function()
            vim.schedule(M.clear)
            return true
          end,
        })
      end
    end
  end)
end

--- Paints the only world or the named one, or takes the paint away.
function M.toggle(file, world)
  if next(painted) then
    M.clear()
    return
  end
  local worlds = {}
  for _, line in ipairs(vim.api.nvim_buf_get_lines(vim.fn.bufnr(file), 0, -1, false)) do
    worlds[#worlds + 1] = line:match('^%s*world%s+([%w_]+)')
  end
  if world or #worlds < 2 then
    M.paint(file, world or worlds[1] or '')
  else
    vim.ui.select(worlds, { prompt = 'Which world?' }, function(chosen)
      if chosen then
        M.paint(file, chosen)
      end
    end)
  end
end

--- The painted tile under the cursor: what was painted, and the index, the column and the row from 0.
function M.tile_under_cursor()
  local buffer = vim.api.nvim_get_current_buf()
  local row, at = unpack(vim.api.nvim_win_get_cursor(0))
  local line = vim.api.nvim_get_current_line()
  for _, of in ipairs(painted[vim.uri_from_bufnr(buffer)] or {}) do
    local client = level.client(of.program)
    for index, place in ipairs(of.space.rows) do
      if client and given(place) and place.line == row - 1 then
        for column = 1, of.space.columns do
          local from, to = place.columns[column], place.columns[column + 1]
          local encoding = client.offset_encoding
          if from and to and byte(line, from, encoding) <= at and at < byte(line, to, encoding) then
            return of, (index - 1) * of.space.columns + column, column - 1, index - 1
          end
        end
      end
    end
  end
end

--- What is told of a tile.
function M.tell(of, index, column, row)
  local space = of.space
  local kind = space.kinds[space.kind[index] + 1]
  local tags = #kind.tags > 0 and table.concat(kind.tags, ', ') or 'empty'
  local lines = { ('%s %s; column %d, row %d of %s'):format(kind.symbol, tags, column + 1, row + 1, space.space) }
  local first = given(space.first[index])
  if first then
    local seconds = first * of.painted.secondsPerStep
    lines[2] = ('first reached at step %d (%.2f s); %d visits'):format(first, seconds, space.visits[index])
  else
    lines[2] = ('not reached with %d nodes of a search, which proves nothing'):format(of.painted.nodes)
  end
  return lines
end

--- Tells of the tile under the cursor, and asks for the inputs that lead there.
function M.tile()
  local of, index, column, row = M.tile_under_cursor()
  if not of then
    vim.notify('hypedc: no painted tile is under the cursor; `:HypedPaint` paints')
    return
  end
  local lines = M.tell(of, index, column, row)
  local about = { world = of.painted.world, space = of.space.space, column = column, row = row }
  level.request(of.program, 'hypedc/wayTo', about, function(found)
    lines[#lines + 1] = found.title
    vim.list_extend(lines, given(found.inputs) and { found.inputs } or found.details)
    vim.lsp.util.open_floating_preview(lines, '', { focus_id = 'hyped.tile' })
  end)
end

function M.enable()
  local groups = {
    ['1'] = 'DiffText', ['2'] = 'DiffChange', ['3'] = 'CursorLine', ['4'] = 'CursorLine',
    Way = 'DiffAdd', Stood = 'DiagnosticUnderlineHint', Unseen = 'DiffDelete',
  }
  for name, link in pairs(groups) do
    vim.api.nvim_set_hl(0, 'HypedPaint' .. name, { link = link, default = true })
  end
end

return M
