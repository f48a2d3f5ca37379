!> The records of a case file, of the files it includes, and of the command line's --set.
module case_file
  use case_scanner, only: record_t, entry_t, scan_case, scan_values, append
  use files, only: folder_of
  use problems, only: problems_t
  use text, only: string_t, shown, lower_case, starts_with, path_from
  implicit none
  private
  public :: case_file_t, load_case, load_case_text

  integer, parameter :: deepest = 16                               !< file in file in file
  character(len=*), parameter :: command_line = 'command line'     !< where an override stands

  type :: case_file_t
    character(len=:), allocatable :: path        !< of the outermost file
    type(record_t), allocatable :: records(:)    !< in order
  contains
    procedure :: count => count_records
    procedure :: find                            !< the i-th record of a group
    procedure :: find_id                         !< the record of a group that has an id
    procedure :: id                              !< of a record
    procedure :: label                           !< '&fill(bed)'
    procedure :: override
  end type case_file_t

contains

  !> Read a file and all it includes, then apply the overrides 'group%key=value'.
  subroutine load_case(path, overrides, file, problems)
    character(len=*), intent(in) :: path
    character(len=*), intent(in) :: overrides(:)
    type(case_file_t), intent(out) :: file
    type(problems_t), intent(inout) :: problems

    type(string_t), allocatable :: nested(:)

    file%path = path
    allocate (file%records(0), nested(0))
    call load(file, path, '', nested, problems)
    call override_all(file, overrides, problems)
  end subroutine load_case

  !> The same of a text, such as the resolved case that a result file holds.
  subroutine load_case_text(text, path, overrides, file, problems)
    character(len=*), intent(in) :: text
    character(len=*), intent(in) :: path           !< the name to blame; relative files are sought beside it
    character(len=*), intent(in) :: overrides(:)
    type(case_file_t), intent(out) :: file
    type(problems_t), intent(inout) :: problems

    type(string_t), allocatable :: nested(:)

    file%path = path
    allocate (file%records(0), nested(0))
    call take_records(file, text, path, nested, problems)
    call override_all(file, overrides, problems)
  end subroutine load_case_text

  recursive subroutine load(file, path, place, outer, problems)
    type(case_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    character(len=*), intent(in) :: place     !< of the &include that asked for it
    type(string_t), intent(in) :: outer(:)    !< the files we are inside of
    type(problems_t), intent(inout) :: problems

    type(string_t), allocatable :: nested(:)
    character(len=:), allocatable :: text, message
    integer :: i

    allocate (nested(size(outer) + 1))
    nested(:size(outer)) = outer
    nested(size(nested))%text = path
    message = ''
    if (size(nested) > deepest) message = 'files include files more than '//shown(deepest)//' deep'
    do i = 1, size(outer)
      if (without_detours(outer(i)%text) == without_detours(path)) message = 'a file includes itself'
    end do
    if (len(message) == 0) call read_text(path, text, message)
    if (len(message) == 0) then
      call take_records(file, text, path, nested, problems)
    else if (len(place) > 0) then
      call problems%add(place//": &include file = '"//path//"': "//message)
    else
      call problems%add(path//': '//message)
    end if
  end subroutine load

  !> A path without 'folder/..', to compare it with others. To open it would be wrong: the folder may be a link.
  pure function without_detours(path) result(short)
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: short

    integer :: up, first

    short = path
    do
      up = index(short, '/../')
      if (up < 2) return
      first = index(short(:up - 1), '/', back=.true.) + 1
      if (short(first:up - 1) == '..' .or. short(first:up - 1) == '.') return
      short = short(:first - 1)//short(up + 4:)
    end do
  end function without_detours

  !> Records of a text, with those of the files it includes in the place of the &include.
  recursive subroutine take_records(file, text, path, nested, problems)
    type(case_file_t), intent(inout) :: file
    character(len=*), intent(in) :: text, path
    type(string_t), intent(in) :: nested(:)
    type(problems_t), intent(inout) :: problems

    type(record_t), allocatable :: records(:)
    integer :: i
    logical :: ok

    allocate (records(0))
    call scan_case(text, path, records, problems)
    do i = 1, size(records)
      if (records(i)%group /= 'include') then
        call append(file%records, records(i))
        cycle
      end if
      associate (entries => records(i)%entries)
        ok = size(entries) == 1
        if (ok) ok = entries(1)%key == 'file' .and. size(entries(1)%values) == 1
        if (ok) ok = entries(1)%values(1)%is_text
        call problems%require(ok, records(i)%place//": &include takes one key: file = 'NAME'")
        if (ok) call load(file, path_from(folder_of(path), entries(1)%values(1)%text), records(i)%place, nested, problems)
      end associate
    end do
  end subroutine take_records

  !> The whole of a text file.
  subroutine read_text(path, text, message)
    character(len=*), intent(in) :: path
    character(len=:), allocatable, intent(out) :: text
    character(len=:), allocatable, intent(inout) :: message  !< why it failed, if it did

    integer :: unit, status, length
    character(len=200) :: reason

    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', &
          iostat=status, iomsg=reason)
    if (status /= 0) then
      message = 'cannot be read: '//trim(reason)
      return
    end if
    inquire (unit=unit, size=length)
    allocate (character(len=max(length, 0)) :: text)
    read (unit, iostat=status, iomsg=reason) text
    close (unit)
    if (status /= 0) message = 'cannot be read: '//trim(reason)
  end subroutine read_text

  subroutine override_all(file, overrides, problems)
    type(case_file_t), intent(inout) :: file
    character(len=*), intent(in) :: overrides(:)
    type(problems_t), intent(inout) :: problems

    integer :: i

    do i = 1, size(overrides)
      call file%override(trim(overrides(i)), problems)
    end do
  end subroutine override_all

  !> Apply 'group%key=value'. Which of several records: 'group(2)%key=value' or 'group(id)%key=value'.
  subroutine override(self, setting, problems)
    class(case_file_t), intent(inout) :: self
    character(len=*), intent(in) :: setting
    type(problems_t), intent(inout) :: problems

    character(len=:), allocatable :: name, group, key, selector
    integer :: equals, percent, record
    type(record_t) :: fresh

    equals = index(setting, '=')
    percent = index(setting, '%')
    if (percent < 2 .or. equals < percent + 2) then
      call problems%add(command_line//': --set '//setting//': write --set group%key=value')
      return
    end if
    name = trim(adjustl(setting(:percent - 1)))
    key = lower_case(trim(adjustl(setting(percent + 1:equals - 1))))
    call split_selector(name, group, selector)
    call select_record(self, group, selector, record, problems)
    if (record < 0) return
    if (record == 0) then
      fresh%group = group
      fresh%place = command_line
      allocate (fresh%entries(0))
      call append(self%records, fresh)
      record = size(self%records)
    end if
    call set_entry(self%records(record), key, trim(adjustl(setting(equals + 1:))))
  end subroutine override

  !> 'fill(bed)' as 'fill' and 'bed'.
  pure subroutine split_selector(name, group, selector)
    character(len=*), intent(in) :: name
    character(len=:), allocatable, intent(out) :: group, selector

    integer :: left, right

    left = index(name, '(')
    right = index(name, ')', back=.true.)
    group = lower_case(name)
    selector = ''
    if (left == 0 .or. right < left) return
    group = lower_case(name(:left - 1))
    selector = name(left + 1:right - 1)
  end subroutine split_selector

  !> The record that an override means: 0 for a new one, -1 where that cannot be told.
  subroutine select_record(file, group, selector, record, problems)
    type(case_file_t), intent(in) :: file
    character(len=*), intent(in) :: group, selector
    integer, intent(out) :: record
    type(problems_t), intent(inout) :: problems

    integer :: n, place

    n = file%count(group)
    if (len(selector) == 0 .and. n < 2) then
      record = file%find(group, 1)
      return
    end if
    record = -1
    place = file%find_id(group, selector)
    if (place == 0 .and. len(selector) > 0 .and. len(selector) < 6 .and. verify(selector, '0123456789') == 0) then
      read (selector, *) place
    end if
    if (place > 0 .and. place <= n) then
      record = file%find(group, place)
    else if (len(selector) == 0) then
      call problems%add(command_line//': &'//group//': there are '//shown(n)//' records; say which: --set ' &
                        //group//'(ID)%key=value, or a number from 1 for ID')
    else
      call problems%add(command_line//': &'//group//'('//selector//'): there is no such record')
    end if
  end subroutine select_record

  !> Replace what the file says of a key, or say it first.
  subroutine set_entry(record, key, text)
    type(record_t), intent(inout) :: record
    character(len=*), intent(in) :: key, text

    type(entry_t) :: entry
    integer :: i

    entry%key = key
    entry%place = command_line
    call scan_values(text, entry%values)
    ! A shell eats quotes: what has none may still be one text, blanks and slashes included.
    if (size(entry%values) > 0) entry%whole = text
    if (size(entry%values) == 1) then
      if (entry%values(1)%is_text) entry%whole = entry%values(1)%text
    end if
    do i = 1, size(record%entries)
      if (record%entries(i)%key /= key) cycle
      record%entries(i) = entry
      return
    end do
    call append(record%entries, entry)
  end subroutine set_entry

  pure function count_records(self, group) result(n)
    class(case_file_t), intent(in) :: self
    character(len=*), intent(in) :: group
    integer :: n

    integer :: i

    n = 0
    do i = 1, size(self%records)
      if (self%records(i)%group == group) n = n + 1
    end do
  end function count_records

  !> Place in `records` of the i-th record of a group, 0 if there is none.
  pure function find(self, group, i) result(place)
    class(case_file_t), intent(in) :: self
    character(len=*), intent(in) :: group
    integer, intent(in) :: i
    integer :: place

    integer :: k, n

    n = 0
    do k = 1, size(self%records)
      if (self%records(k)%group == group) n = n + 1
      place = k
      if (n == i) return
    end do
    place = 0
  end function find

  !> Which record of a group has this id, counted within the group; 0 if none has.
  pure function find_id(self, group, id) result(i)
    class(case_file_t), intent(in) :: self
    character(len=*), intent(in) :: group, id
    integer :: i

    if (len(id) > 0) then
      do i = 1, self%count(group)
        if (self%id(self%find(group, i)) == id) return
      end do
    end if
    i = 0
  end function find_id

  !> The id of a record, nothing if it has none.
  pure function id(self, place)
    class(case_file_t), intent(in) :: self
    integer, intent(in) :: place  !< in `records`
    character(len=:), allocatable :: id

    integer :: i

    id = ''
    if (place == 0) return
    associate (entries => self%records(place)%entries)
      do i = 1, size(entries)
        if (entries(i)%key /= 'id' .or. size(entries(i)%values) /= 1) cycle
        id = entries(i)%values(1)%text
        return
      end do
    end associate
  end function id

  !> How a message names a record.
  pure function label(self, group, place)
    class(case_file_t), intent(in) :: self
    character(len=*), intent(in) :: group
    integer, intent(in) :: place  !< in `records`
    character(len=:), allocatable :: label

    label = '&'//group
    if (len(self%id(place)) > 0) label = label//'('//self%id(place)//')'
  end function label

end module case_file
