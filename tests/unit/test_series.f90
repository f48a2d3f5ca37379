!> Tables against time: rows reach the file, a continued run drops what came later, a script may read while it runs.
!> tests/test_output.py reads the same file with h5py.
program test_series
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use files, only: make_folder
  use hdf5_arrays, only: get_columns
  use hdf5_file, only: hdf5_file_t, start_hdf5, stop_hdf5
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use provenance, only: provenance_t
  use series_file, only: series_file_t, column_t
  implicit none

  type(column_t), parameter :: columns(3) = [column_t('height', 'm', 'of the bed'), &
                                             column_t('velocity', 'm/s', 'mean', components=3), &
                                             column_t('profile', '1', 'along a line', components=3, places=4)]
  type(communicator_t) :: comm
  type(outcome_t) :: outcome
  type(provenance_t) :: origin
  character(len=:), allocatable :: folder
  logical :: ok

  call start_ranks(comm)
  call start_hdf5()
  folder = working_folder()
  if (comm%is_root()) call make_folder(folder, outcome)
  origin = provenance_t('a test', '0.1', 'abc', '&run /')
  call write_rows(0, 1200, .true.)
  call write_rows(1000, 1100, .false.)    ! 1001 to 1200 are dropped, 1000 is there already
  if (comm%is_root()) then
    call expect(.not. outcome%failed(), 'all rows are written')
    if (outcome%failed()) print '(a)', outcome%message
    call read_back(ok)
    call expect(ok, 'every time is in the file once, with its value')
    call finish()
  end if
  call stop_hdf5()
  call stop_ranks()

contains

  function working_folder() result(folder)
    character(len=:), allocatable :: folder

    character(len=300) :: argument

    write (argument, '(a,i0)') 'build/tests/series_', comm%size
    if (command_argument_count() > 0) call get_command_argument(1, argument)
    folder = trim(argument)
  end function working_folder

  !> Rows `from` to `to` at the times 0.001 row; a second table has every tenth and, when continued, a new column.
  subroutine write_rows(from, to, fresh)
    integer, intent(in) :: from, to
    logical, intent(in) :: fresh

    type(series_file_t) :: series
    type(column_t) :: count, half
    integer :: main, other, i, k

    count = column_t('count', '1', 'of rows')
    half = column_t('half', '1', 'of the count')
    if (fresh) call series%open(folder//'/monitor.h5', comm, origin, outcome)
    if (.not. fresh) call series%open(folder//'/monitor.h5', comm, origin, outcome, 0.001_wp*from)
    call series%add_table('/series', columns, main)
    if (fresh) call series%add_table('/monitors/other', [count], other)
    if (.not. fresh) call series%add_table('/monitors/other', [count, half], other)
    call series%annotate(other, 'kind', text='box')
    call series%annotate(other, 'position', numbers=reshape(real([1, 2, 3, 4, 5, 6], wp), [3, 2]), unit='m')
    do i = from, to
      call series%append(main, 0.001_wp*i, [real(wp) :: i, 10*i, 20*i, 30*i, (i + 0.01_wp*k, k=1, 12)])
      if (modulo(i, 10) == 0) call series%append(other, 0.001_wp*i, [real(wp) :: i, pack([0.5_wp*i], .not. fresh)])
    end do
    call series%close(outcome)
  end subroutine write_rows

  subroutine read_back(ok)
    logical, intent(out) :: ok

    type(hdf5_file_t) :: file
    type(outcome_t) :: reading
    real(wp) :: time(1101), height(1101)
    integer :: i

    time = 0
    height = 0
    call file%open(folder//'/monitor.h5', .false.)
    ok = all([file%shape_of('/series/time'), file%shape_of('/series/height')] == 1101)
    call get_columns(file, '/series/time', time, 0_i8)
    call get_columns(file, '/series/height', height, 0_i8)
    call file%close(reading)
    ok = ok .and. .not. reading%failed() .and. all(abs(time - [(0.001_wp*i, i=0, 1100)]) < 1.0e-12_wp) .and. &
         all(nint(height) == [(i, i=0, 1100)])
  end subroutine read_back

end program test_series
