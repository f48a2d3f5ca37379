!> Files of parcels as tables of named columns.
!>
!>   x, y, z     centre [m]
!>   d           diameter of the real particles [m]
!>   W or D      real particles per parcel [-], or the diameter at which the parcel touches others [m]
!>   vx, vy, vz  velocity [m/s]
!>
!> A .h5 file has one data set of each name, all of one length; any other is a table as in csv_file.
module parcel_table
  use csv_file, only: read_csv
  use hdf5_arrays, only: get_columns
  use hdf5_file, only: hdf5_file_t
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use problems, only: problems_t
  use text, only: shown
  implicit none
  private
  public :: parcel_table_t, read_parcel_table, column_names, place_of_row

  character(len=2), parameter :: column_names(9) = ['x ', 'y ', 'z ', 'd ', 'W ', 'D ', 'vx', 'vy', 'vz']

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
      call read_csv(path, column_names, table%given, table%values, table%line, problems)
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
