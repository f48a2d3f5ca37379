!> Files of parcels as tables of named columns.
!>
!>   x, y, z     centre [m]
!>   d           diameter of the real particles [m]
!>   W or D      real particles per parcel [-], or the diameter at which the parcel touches others [m]
!>   vx, vy, vz  velocity [m/s]
!>
!> A .csv file names its columns in its first line, in any order, separated by commas; blank lines and lines that
!> begin with # are passed over. A .h5 file has one data set of each name, all of one length.
module parcel_table
  use case_scanner, only: word_t
  use case_values, only: to_real
  use hdf5_arrays, only: get_columns
  use hdf5_file, only: hdf5_file_t
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use problems, only: problems_t
  use text, only: string_t, shown, split
  implicit none
  private
  public :: parcel_table_t, read_parcel_table, column_names, place_of_row

  character(len=2), parameter :: column_names(9) = ['x ', 'y ', 'z ', 'd ', 'W ', 'D ', 'vx', 'vy', 'vz']
  character(len=*), parameter :: all_names = 'x, y, z, d, W, D, vx, vy, vz'

  type :: parcel_table_t
    character(len=:), allocatable :: path
    logical :: given(9) = .false.          !< whether the file has each of column_names
    real(wp), allocatable :: values(:, :)  !< (9,rows); 0 in columns the file does not have
    integer, allocatable :: line(:)        !< (rows) where each stands in a .csv file; in others its number
  end type parcel_table_t

contains

  !> Read a file; all its mistakes are noted with file and line.
  subroutine read_parcel_table(path, table, problems)
    character(len=*), intent(in) :: path
    type(parcel_table_t), intent(out) :: table
    type(problems_t), intent(inout) :: problems

    table%path = path
    if (index(path, '.h5', back=.true.) == len(path) - 2) then
      call read_hdf5(table, problems)
    else
      call read_csv(table, problems)
    end if
    if (problems%count() > 0) return
    call problems%require(all(table%given(1:4)), path//': columns x, y, z and d are needed')
    call problems%require(.not. all(table%given(5:6)), path//': give W or D, not both')
    call problems%require(all(table%given(7:9)) .or. .not. any(table%given(7:9)), &
                          path//': give all of vx, vy and vz, or none')
    call problems%require(size(table%line) > 0, path//': holds no parcels')
  end subroutine read_parcel_table

  !> Where a row stands, for a message.
  pure function place_of_row(table, row) result(place)
    type(parcel_table_t), intent(in) :: table
    integer, intent(in) :: row
    character(len=:), allocatable :: place

    place = table%path//':'//shown(table%line(row))
  end function place_of_row

  subroutine read_csv(table, problems)
    type(parcel_table_t), intent(inout) :: table
    type(problems_t), intent(inout) :: problems

    character(len=:), allocatable :: text
    type(string_t), allocatable :: words(:)
    integer, allocatable :: columns(:), ends(:)
    integer :: line, rows, first

    call read_text(table%path, text, problems)
    if (problems%count() > 0) return
    ends = pack([(line, line=1, len(text))], [(text(line:line) == new_line('a'), line=1, len(text))])
    allocate (table%values(9, size(ends)), source=0.0_wp)
    allocate (table%line(size(ends)), source=0)
    rows = 0
    first = 1
    do line = 1, size(ends)
      words = split(content_of(text(first:ends(line) - 1)), ',')
      first = ends(line) + 1
      if (size(words) == 0) cycle
      if (allocated(columns)) then
        rows = rows + 1
        table%line(rows) = line
        call read_row(words, columns, table%path//':'//shown(line), table%values(:, rows), problems)
      else
        call read_header(words, table%path//':'//shown(line), columns, problems)
        if (problems%count() > 0) return
        table%given(columns) = .true.
      end if
    end do
    table%values = table%values(:, :rows)
    table%line = table%line(:rows)
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

  !> Which of column_names each column is.
  subroutine read_header(words, place, columns, problems)
    type(string_t), intent(in) :: words(:)
    character(len=*), intent(in) :: place
    integer, allocatable, intent(out) :: columns(:)
    type(problems_t), intent(inout) :: problems

    integer :: i, j

    allocate (columns(size(words)), source=0)
    do i = 1, size(words)
      do j = 1, size(column_names)
        if (words(i)%text == trim(column_names(j))) columns(i) = j
      end do
      call problems%require(columns(i) > 0, place//": column '"//words(i)%text//"' is not one of "//all_names)
      call problems%require(columns(i) == 0 .or. all(columns(:i - 1) /= columns(i)), &
                            place//": column '"//words(i)%text//"' stands twice")
    end do
  end subroutine read_header

  subroutine read_row(words, columns, place, values, problems)
    type(string_t), intent(in) :: words(:)
    integer, intent(in) :: columns(:)
    character(len=*), intent(in) :: place
    real(wp), intent(inout) :: values(9)
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
      call problems%require(len(message) == 0, place//': '//trim(column_names(columns(i)))//" = '"// &
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

  subroutine read_hdf5(table, problems)
    type(parcel_table_t), intent(inout) :: table
    type(problems_t), intent(inout) :: problems

    type(hdf5_file_t) :: file
    type(outcome_t) :: outcome
    real(wp), allocatable :: values(:)
    integer :: i, rows

    call file%open(table%path, .false.)
    rows = 0
    do i = 1, size(column_names)
      table%given(i) = file%has('/'//trim(column_names(i)))
      if (.not. table%given(i)) cycle
      associate (extent => file%shape_of('/'//trim(column_names(i))))
        if (.not. allocated(table%values)) then
          rows = int(product(extent))
          allocate (table%values(9, rows), source=0.0_wp)
        end if
        if (size(extent) /= 1 .or. product(extent) /= rows) then
          call problems%add(table%path//": data set '"//trim(column_names(i))//"' is not as long as the others")
          cycle
        end if
      end associate
      if (.not. allocated(values)) allocate (values(rows))
      call get_columns(file, '/'//trim(column_names(i)), values, 0_i8)
      table%values(i, :) = values
    end do
    call file%close(outcome)
    if (outcome%failed()) call problems%add(outcome%message)
    table%line = [(i, i=1, rows)]
  end subroutine read_hdf5

end module parcel_table
