!> The HDF5 layer: shared files written by all ranks and read back, files of the root alone, failures that are told.
program test_hdf5
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use hdf5_arrays, only: share_t, share_of, share_of_root, put_columns, get_columns, put_block, get_block, &
    put_attribute, get_attribute
  use hdf5_file, only: hdf5_file_t, start_hdf5, stop_hdf5, real_kind, single_kind, long_kind, integer_kind
  use kinds, only: wp, sp, i8
  use outcome, only: outcome_t, exit_environment
  implicit none

  character(len=*), parameter :: folder = 'build/tests/'
  type(communicator_t) :: comm
  logical :: ok(12)

  call start_ranks(comm)
  call start_hdf5()
  call execute_command_line('mkdir -p '//folder)
  call test_columns(ok(1:4))
  call test_blocks(ok(5:6))
  call test_attributes(ok(7:8))
  call test_failures(ok(9:10))
  call test_root_file(ok(11:12))
  ok = [.not. comm%any_of(.not. ok(1)), .not. comm%any_of(.not. ok(2)), ok(3:)]
  if (comm%is_root()) then
    call expect(ok(1), 'vectors of 0, 1, 2, ... columns per rank come back')
    call expect(ok(2), 'long integers come back')
    call expect(ok(3), 'a dataset grows by what is appended')
    call expect(ok(4), 'and can be cut again')
    call expect(ok(5), 'blocks of a grid come back')
    call expect(ok(6), 'a compressed grid in single precision has the shape of the grid')
    call expect(ok(7), 'numbers come back from attributes, also when set twice')
    call expect(ok(8), 'a long text fits into an attribute')
    call expect(ok(9), 'a file in a missing folder fails with its name')
    call expect(ok(10), 'a missing dataset fails and later calls do nothing')
    call expect(ok(11), 'the root alone writes and extends a file')
    call expect(ok(12), 'has tells what there is')
    call finish()
  end if
  call stop_hdf5()
  call stop_ranks()

contains

  !> Rank r gives r columns the first time and one the second time.
  subroutine test_columns(ok)
    logical, intent(out) :: ok(4)

    type(hdf5_file_t) :: file
    type(outcome_t) :: outcome
    type(share_t) :: share
    real(wp) :: x(3, comm%rank), back(3, comm%rank)
    integer(i8) :: id(comm%rank), id_back(comm%rank), total
    integer :: i

    do i = 1, comm%rank
      x(:, i) = sin([1, 2, 3]*real(100*comm%rank + i, wp))
      id(i) = 10_i8**12*comm%rank + i
    end do
    share = share_of(comm, comm%rank)
    total = share%total
    call file%create(folder//'columns.h5', comm)
    call file%make('/group/x', real_kind, [3_i8, 0_i8], [3_i8, 16_i8])
    call file%make('/group/id', long_kind, [total])
    call put_columns(file, '/group/x', x, share, 0_i8)
    call put_columns(file, '/group/id', id, share)
    call put_columns(file, '/group/x', reshape([1.0_wp, 2.0_wp, 3.0_wp], [3, 1]), share_of(comm, 1), total)
    call file%close(outcome)
    call tell(outcome)
    call file%open(folder//'columns.h5', .true., comm)
    ok(3) = all(file%shape_of('/group/x') == [3_i8, total + comm%size])
    back = 0
    id_back = 0
    call get_columns(file, '/group/x', back, share%before)
    call get_columns(file, '/group/id', id_back, share%before)
    call file%resize('/group/x', total)
    ok(4) = all(file%shape_of('/group/x') == [3_i8, total])
    call file%close(outcome)
    call tell(outcome)
    ok(1) = all(abs(back - x) <= 0.0_wp) .and. .not. outcome%failed()
    ok(2) = all(id == id_back)
  end subroutine test_columns

  !> A grid of 4 x 3 x 2*ranks cells in layers of 2.
  subroutine test_blocks(ok)
    logical, intent(out) :: ok(2)

    type(hdf5_file_t) :: file
    type(outcome_t) :: outcome
    real(wp) :: f(4, 3, 2), back(4, 3, 2)
    integer(i8) :: grid(3)
    integer :: lower(3), i

    grid = [4, 3, 2*comm%size]
    lower = [1, 1, 1 + 2*comm%rank]
    f = reshape([(exp(-real(i + 24*comm%rank, wp)), i=1, 24)], [4, 3, 2])
    call file%create(folder//'blocks.h5', comm)
    call file%make('/f', real_kind, grid)
    call file%make('/g', single_kind, [3_i8, grid, 0_i8], [3_i8, 4_i8, 3_i8, 2_i8, 1_i8], compressed=.true.)
    call put_block(file, '/f', f, lower)
    do i = 0, 2
      call put_block(file, '/g', spread(real(f, sp), 1, 3), lower, int(i, i8))
    end do
    back = 0
    call get_block(file, '/f', back, lower)
    ok(2) = all(file%shape_of('/g') == [3_i8, grid, 3_i8])
    call file%close(outcome)
    call tell(outcome)
    ok(1) = all(abs(back - f) <= 0.0_wp) .and. .not. outcome%failed()
    ok(2) = ok(2) .and. .not. outcome%failed()
  end subroutine test_blocks

  subroutine test_attributes(ok)
    logical, intent(out) :: ok(2)

    type(hdf5_file_t) :: file
    type(outcome_t) :: outcome
    integer :: n
    real(wp) :: time

    n = 0
    time = 0
    call file%create(folder//'attributes.h5', comm)
    call file%make_group('/notes')
    call put_attribute(file, '/notes', 'n', 7)
    call put_attribute(file, '/notes', 'n', 8)
    call put_attribute(file, '/', 'time', 0.1_wp)
    call put_attribute(file, '/notes', 'sizes', [1.0_wp, 2.0_wp])
    call get_attribute(file, '/notes', 'n', n)
    call get_attribute(file, '/', 'time', time)
    call file%close(outcome)
    call tell(outcome)
    ok(1) = n == 8 .and. abs(time - 0.1_wp) <= 0.0_wp .and. .not. outcome%failed()
    call file%open(folder//'attributes.h5', .true., comm)
    call put_attribute(file, '/notes', 'case', repeat('&gas density = 1.2 /'//new_line('a'), 5000))
    call put_attribute(file, '/notes', 'case', repeat('&gas density = 1.3 /'//new_line('a'), 6000))
    call put_attribute(file, '/notes', 'empty', '')
    call file%close(outcome)
    call tell(outcome)
    ok(2) = .not. outcome%failed()
  end subroutine test_attributes

  subroutine test_failures(ok)
    logical, intent(out) :: ok(2)

    type(hdf5_file_t) :: file
    type(outcome_t) :: first, second

    call file%create(folder//'nowhere/x.h5', comm)
    call file%make('/x', integer_kind, [1_i8])
    call file%close(first)
    ok(1) = .false.
    if (first%failed()) ok(1) = first%code == exit_environment .and. &
                                index(first%message, folder//"nowhere/x.h5'): its folder does not exist") > 0
    call file%create(folder//'failures.h5', comm)
    call put_columns(file, '/absent', [1, 2], share_of_root(comm, 2))
    call put_columns(file, '/also_absent', [1, 2], share_of_root(comm, 2))
    call file%close(second)
    ok(2) = .false.
    if (second%failed()) ok(2) = second%message == "cannot find /absent ('"//folder//"failures.h5')"
  end subroutine test_failures

  subroutine test_root_file(ok)
    logical, intent(out) :: ok(2)

    type(hdf5_file_t) :: file
    type(outcome_t) :: outcome
    integer :: numbers(3), i
    logical :: there(4)

    ok = .true.
    if (.not. comm%is_root()) return
    call file%create(folder//'root.h5')
    call file%make('/a/b/n', integer_kind, [0_i8], [8_i8])
    do i = 1, 3
      call put_columns(file, '/a/b/n', [i], share_t(1, 0, 1), i - 1_i8)
    end do
    call file%close(outcome)
    call tell(outcome)
    call file%open(folder//'root.h5', .false.)
    numbers = 0
    call get_columns(file, '/a/b/n', numbers, 0_i8)
    there = [file%has('/a/b/n'), file%has('/a'), file%has('/a/c/n'), file%has('/a/b/m')]
    ok(2) = all(there .eqv. [.true., .true., .false., .false.])
    call file%close(outcome)
    call tell(outcome)
    ok(1) = all(numbers == [1, 2, 3]) .and. .not. outcome%failed()
  end subroutine test_root_file

  subroutine tell(outcome)
    type(outcome_t), intent(in) :: outcome

    if (outcome%failed()) print '(a)', outcome%message
  end subroutine tell

end program test_hdf5
