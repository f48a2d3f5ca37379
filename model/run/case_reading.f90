!> From a case file, or a text that was one, to a checked case; and what can be said in a case file.
module case_reading
  use case, only: case_t, declare_case
  use case_catalogue, only: print_group_help, write_markdown
  use case_checks, only: check_case
  use case_file, only: case_file_t, load_case, load_case_text
  use case_keys, only: keys_t
  use communicator, only: communicator_t
  use coarse_graining, only: scale_contacts
  use mesh_checks, only: check_meshes
  use mesh_reading, only: read_meshes
  use problems, only: problems_t
  implicit none
  private
  public :: read_case, read_case_text, print_help, write_inputs_markdown

contains

  !> Read a case file. All mistakes are added to the problems; with any, the case is of no use. All ranks take part.
  subroutine read_case(file, overrides, case, problems, comm)
    character(len=*), intent(in) :: file
    character(len=*), intent(in) :: overrides(:)  !< 'group%key=value', stronger than the file
    type(case_t), intent(out) :: case
    type(problems_t), intent(inout) :: problems
    type(communicator_t), intent(in) :: comm

    type(case_file_t) :: records

    call load_case(file, overrides, records, problems)
    call read_records(records, case, problems, comm)
  end subroutine read_case

  !> The same from the text of a case, such as the `text` of another. Its paths are relative to where the
  !> program was started. Meshes are read by every rank that calls.
  subroutine read_case_text(text, overrides, case, problems)
    character(len=*), intent(in) :: text
    character(len=*), intent(in) :: overrides(:)
    type(case_t), intent(out) :: case
    type(problems_t), intent(inout) :: problems

    type(case_file_t) :: records

    call load_case_text(text, 'stored case', overrides, records, problems)
    call read_records(records, case, problems)
  end subroutine read_case_text

  subroutine read_records(records, case, problems, comm)
    type(case_file_t), intent(in) :: records
    type(case_t), intent(inout) :: case
    type(problems_t), intent(inout) :: problems
    type(communicator_t), intent(in), optional :: comm

    type(keys_t) :: all, keys

    call list_all(all)
    call keys%begin(records, all%groups, problems)
    call declare_case(case, keys)
    call read_meshes(case, keys, comm)
    call scale_contacts(case, keys)
    call check_case(case, keys)
    call check_meshes(case, keys)
    case%file = records%path
    case%text = keys%resolved
    problems = keys%problems
  end subroutine read_records

  !> All groups and keys there are.
  subroutine list_all(keys)
    type(keys_t), intent(inout) :: keys

    type(case_t) :: nothing

    call keys%list()
    call declare_case(nothing, keys)
  end subroutine list_all

  !> What --help prints of the case file: all groups, or the keys of one.
  subroutine print_help(group, unit)
    character(len=*), intent(in) :: group  !< nothing: all groups
    integer, intent(in) :: unit

    type(keys_t) :: all

    call list_all(all)
    call print_group_help(all%groups, group, unit)
  end subroutine print_help

  !> doc/inputs.md: the same as tables.
  subroutine write_inputs_markdown(unit)
    integer, intent(in) :: unit

    type(keys_t) :: all

    call list_all(all)
    call write_markdown(all%groups, unit)
  end subroutine write_inputs_markdown

end module case_reading
