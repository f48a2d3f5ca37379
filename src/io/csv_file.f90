!> Tables of named columns in text files (.csv): the first line names the columns, in any order, separated by commas; blank lines
!> and lines that begin with # are passed over.
module csv_file
  use case_scanner, only: word_t
  use case_values, only: to_real
  use kinds, only: wp
  use problems, only: problems_t
  use text, only: string_t, shown, split
  implicit none
  private
  public :: read_csv

contains

  !> Read a table; all its mistakes are noted with file and line.
  subroutine read_csv(path, names, given, values, line, problems)
    character(len=*), intent(in) :: path
    character(len=*), intent(in) :: names(:)             !< that columns may have
    logical, intent(out) :: given(size(names))           !< whether the file has each
    real(wp), allocatable, intent(out) :: values(:,:)    !< (names,rows); 0 in columns the file does not have
    integer, allocatable, intent(out) :: line(:)         !< (rows) where each stands
    type(problems_t), intent(inout) :: problems

    character(len=:), allocatable :: text
    type(string_t), allocatable :: words(:)
    integer, allocatable :: columns(:), ends(:)
    integer :: l, rows, first

    given = .false.
    allocate (values(size(names), 0), line(0))
    call read_text(path, text, problems)
    if (problems%count() > 0) return
    ends = pack([(l, l=1, len(text))], [(text(l:l) == new_line('a'), l=1, len(text))])
    deallocate (values, line)
    allocate (values(size(names), size(ends)), source=0.0_wp)
    allocate (line(size(ends)), source=0)
    rows = 0
    first = 1
    do l = 1, size(ends)
      words = split(content_of(text(first:ends(l) - 1)), ',')
      first = ends(l) + 1
      if (size(words) == 0) cycle
      if (allocated(columns)) then
        rows = rows + 1
        line(rows) = l
        call read_row(words, names, columns, path//':'//shown(l), values(:, rows), problems)
      else
        call read_header(words, names, path//':'//shown(l), columns, problems)
        if (problems%count() > 0) exit
        given(columns) = .true.
      end if
    end do
    values = values(:, :rows)
    line = line(:rows)
  end subroutine read_csv

  !> A line without what is no value: a comment, the mark that lines of Windows end with.
  pure function content_of(line) result(content)
    character(len=*), intent(in) :: line
    character(len=len(line)) :: content

    content = line
    if (len(line) == 0) return
    if (line(len(line):) == achar(13)) content(len(line):) = ' '
    if (index(adjustl(content), '#') == 1) content = ''
  end function content_of

  !> Which of the names each column has.
  subroutine read_header(words, names, place, columns, problems)
    type(string_t), intent(in) :: words(:)
    character(len=*), intent(in) :: names(:), place
    integer, allocatable, intent(out) :: columns(:)
    type(problems_t), intent(inout) :: problems

    character(len=:), allocatable :: all_names
    integer :: i, j

    all_names = trim(names(1))
    do j = 2, size(names)
      all_names = all_names//', '//trim(names(j))
    end do
    allocate (columns(size(words)), source=0)
    do i = 1, size(words)
      do j = 1, size(names)
        if (words(i)%text == trim(names(j))) columns(i) = j
      end do
      call problems%require(columns(i) > 0, place//": column '"//words(i)%text//"' is not one of "//all_names)
      call problems%require(columns(i) == 0 .or. all(columns(:i - 1) /= columns(i)), &
                            place//": column '"//words(i)%text//"' stands twice")
    end do
  end subroutine read_header

  subroutine read_row(words, names, columns, place, values, problems)
    type(string_t), intent(in) :: words(:)
    character(len=*), intent(in) :: names(:)
    integer, intent(in) :: columns(:)
    character(len=*), intent(in) :: place
    real(wp), intent(inout) :: values(:)
    type(problems_t), intent(inout) :: problems

    type(word_t) :: word
    character(len=:), allocatable :: message
    integer :: i

    if (size(words) /= size(columns)) then
      call problems%add(place//': '//shown(size(words))//' values for '//shown(size(columns))//' columns')
      return
    end if
    do i = 1, size(words)
      word%text = words(i)%text
      call to_real(word, values(columns(i)), message)
      call problems%require(len(message) == 0, place//': '//trim(names(columns(i)))//" = '"// &
                            words(i)%text//"' "//message)
    end do
  end subroutine read_row

  !> All of a text file, with an end to its last line.
  subroutine read_text(path, text, problems)
    character(len=*), intent(in) :: path
    character(len=:), allocatable, intent(out) :: text
    type(problems_t), intent(inout) :: problems

    integer :: unit, status, length
    character(len=200) :: reason

    text = ''
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', &
          iostat=status, iomsg=reason)
    if (status == 0) then
      inquire (unit=unit, size=length)
      text = repeat(' ', length)//new_line('a')
      read (unit, iostat=status, iomsg=reason) text(:length)
      close (unit)
    end if
    call problems%require(status == 0, path//': cannot be read: '//trim(reason))
  end subroutine read_text

end module csv_file
