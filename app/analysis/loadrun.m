% SPDX-License-Identifier: MIT
function run = loadrun (directory)
  % RUN = loadrun (DIRECTORY): a run of dampline, for Octave 7 and MATLAB R2016b or newer.
  %
  %   run = loadrun ('run1');
  %   run.coulomb.value, run.coulomb.std, run.coulomb.unit     a parameter, by its name
  %   run.about.trust, run.about.start_utc                     all of parameters.json
  %   plot (run.tables.curve.velocity_mps, run.tables.curve.force_n)
  %
  % run.tables has each CSV file with its columns by their header: numbers as columns of doubles
  % (no number: NaN), else cells of text. Units are those of the files: SI, and the name of a column
  % ends in its unit. Names that are none in this language (terms of --method wavelet) are made
  % valid: x^3 becomes x_3.
  run.about = jsondecode (fileread (fullfile (directory, 'parameters.json')));
  parameters = as_cells (run.about.parameters);
  for i = 1:numel (parameters)
    p = parameters{i};
    run.(valid_name (p.name)) = struct ('value', number_of (p.value), 'std', number_of (p.std), ...
                                        'unit', p.unit);
  end
  run.tables = struct ();
  files = dir (fullfile (directory, '*.csv'));
  for i = 1:numel (files)
    [~, stem] = fileparts (files(i).name);
    run.tables.(stem) = read_table (fullfile (directory, files(i).name));
  end
end

function list = as_cells (decoded)
  % Objects with the same members are decoded as a structure array, others as cells.
  if iscell (decoded)
    list = decoded;
  else
    list = num2cell (decoded);
  end
end

function x = number_of (decoded)
  if isempty (decoded)
    x = NaN;
  else
    x = double (decoded);
  end
end

function name = valid_name (text)
  name = regexprep (text, '[^A-Za-z0-9]+', '_');
  if isempty (regexp (name, '^[A-Za-z]', 'once'))
    name = ['x' name];
  end
end

function table = read_table (file)
  lines = strsplit (fileread (file), sprintf ('\n'));
  lines = lines(~cellfun (@isempty, lines));
  header = strsplit (lines{1}, ',');
  cells = cell (numel (lines) - 1, numel (header));
  for i = 2:numel (lines)
    cells(i - 1, :) = strsplit (lines{i}, ',', 'CollapseDelimiters', false);
  end
  table = struct ();
  for j = 1:numel (header)
    column = cells(:, j);
    numbers = str2double (column);
    is_number = ~isnan (numbers) | cellfun (@isempty, column) | strcmp (column, 'nan');
    if all (is_number)
      table.(valid_name (header{j})) = numbers;
    else
      table.(valid_name (header{j})) = column;
    end
  end
end
