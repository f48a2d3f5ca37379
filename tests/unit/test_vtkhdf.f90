!> Parcels and gas over several steps, continued after steps were dropped. What VTK and h5py find in the files is
!> tested by tests/test_output.py, which runs this program with a folder as its argument.
!>
!> Parcel `id` of step s is at (sin(id), cos(id), s/10); step s has 10000 + 1000 s parcels, so that steps share the
!> chunks of the file, and the last rank has none of those of step 1. The void fraction of cell (i,j,k) is
!> 1/(i + 10 j + 100 k + 1000 s), its velocity (i, j, k + s).
program test_vtkhdf
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use files, only: make_folder, exists
  use hdf5_arrays, only: get_columns, get_attribute
  use hdf5_file, only: hdf5_file_t, start_hdf5, stop_hdf5
  use grid_axis, only: graded_axis
  use kinds, only: wp, i8
  use mesh, only: mesh_t, new_mesh, new_uniform_mesh
  use outcome, only: outcome_t
  use provenance, only: provenance_t
  use vtkhdf_gas, only: vtkhdf_gas_t
  use vtkhdf_parcels, only: vtkhdf_parcels_t
  implicit none

  integer, parameter :: cells(3) = [6, 10, 4]
  real(wp), parameter :: corner(3) = [0.1_wp, 0.2_wp, 0.3_wp], edge(3) = [0.01_wp, 0.02_wp, 0.03_wp]
  type(communicator_t) :: comm
  type(outcome_t) :: outcome
  type(provenance_t) :: origin
  character(len=:), allocatable :: folder
  integer(i8) :: counts(5)
  real(wp) :: times(5)
  integer :: steps

  call start_ranks(comm)
  call start_hdf5()
  folder = working_folder()
  if (comm%is_root()) call make_folder(folder, outcome)
  origin = provenance_t('a test', '0.1', 'abc', '&run title = ''a test'' /'//new_line('a'))
  call write_steps(0, 6)
  call write_steps(2, 4)       ! steps 3 to 6 are dropped, 2 is there already
  if (comm%is_root()) then
    call expect(.not. outcome%failed(), 'all steps are written')
    if (outcome%failed()) print '(a)', outcome%message
    call read_back()
    call expect(steps == 5, 'steps after the time of the restart are gone, later ones follow')
    call expect(all(abs(times - 0.1_wp*[0, 1, 2, 3, 4]) < 1.0e-12_wp), 'every time is there once')
    call expect(all(counts == 1000*[10, 11, 12, 13, 14]), 'the number of parcels of every step is right')
    call expect(exists(folder//'/parcels.xmf'), 'the sidecar of the parcels is written')
    call expect(exists(folder//'/gas.xmf'), 'the sidecar of the gas is written')
    call finish()
  end if
  call stop_hdf5()
  call stop_ranks()

contains

  function working_folder() result(folder)
    character(len=:), allocatable :: folder

    character(len=300) :: argument

    write (argument, '(a,i0)') 'build/tests/vtkhdf_', comm%size
    if (command_argument_count() > 0) call get_command_argument(1, argument)
    folder = trim(argument)
  end function working_folder

  !> Steps `from` to `to`; from > 0 is a restart at the time of that step.
  subroutine write_steps(from, to)
    integer, intent(in) :: from, to

    type(vtkhdf_parcels_t) :: parcels
    type(vtkhdf_gas_t) :: gas, graded
    type(boxes_t) :: boxes
    type(mesh_t) :: even, uneven
    integer :: s

    call new_boxes(comm, cells, [.false., .false., .false.], boxes, outcome)
    even = new_uniform_mesh(corner, corner + cells*edge, cells, boxes%periodic)
    uneven = new_mesh([even%axis(1), graded_axis(corner(2) + edge(2)*[(real(s*s, wp), s=0, cells(2))], .false.), even%axis(3)])
    if (from == 0) then
      call parcels%open(folder//'/parcels.vtkhdf', comm, origin, outcome)
      call gas%open(folder//'/gas.vtkhdf', boxes, even, origin, outcome)
      call graded%open(folder//'/graded.vtkhdf', boxes, uneven, origin, outcome)
    else
      call parcels%open(folder//'/parcels.vtkhdf', comm, origin, outcome, 0.1_wp*from)
      call gas%open(folder//'/gas.vtkhdf', boxes, even, origin, outcome, 0.1_wp*from)
      call graded%open(folder//'/graded.vtkhdf', boxes, uneven, origin, outcome, 0.1_wp*from)
    end if
    do s = from, to
      call write_parcels(parcels, s)
      call write_gas(gas, boxes, s)
      call write_gas(graded, boxes, s)
    end do
    call parcels%close(outcome)
    call gas%close(outcome)
    call graded%close(outcome)
  end subroutine write_steps

  subroutine write_parcels(file, s)
    type(vtkhdf_parcels_t), intent(inout) :: file
    integer, intent(in) :: s

    integer :: total, low, high, i, ranks
    real(wp), allocatable :: position(:,:)
    integer(i8), allocatable :: id(:)

    total = 10000 + 1000*s
    ranks = merge(comm%size - 1, comm%size, s == 1 .and. comm%size > 1)
    low = total*comm%rank/ranks
    high = min(total*(comm%rank + 1)/ranks, total)
    allocate (id(max(high - low, 0)), position(3, max(high - low, 0)))
    id = [(int(i, i8), i=low + 1, high)]
    do i = 1, size(id)
      position(:, i) = [sin(real(id(i), wp)), cos(real(id(i), wp)), 0.1_wp*s]
    end do
    call file%begin_step(0.1_wp*s, position)
    call file%add('diameter', 1.0e-3_wp/id, 'm')
    call file%add('velocity', 2*position, 'm/s')
    call file%add('id', id, '1')
    call file%add('powder', int(modulo(id, 3_i8)), '1')
    call file%end_step(outcome)
  end subroutine write_parcels

  subroutine write_gas(file, boxes, s)
    type(vtkhdf_gas_t), intent(inout) :: file
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: s

    real(wp) :: eps(boxes%n(1), boxes%n(2), boxes%n(3)), u(3, boxes%n(1), boxes%n(2), boxes%n(3))
    integer :: i, j, k, cell(3)

    do k = 1, boxes%n(3)
      do j = 1, boxes%n(2)
        do i = 1, boxes%n(1)
          cell = boxes%lo - 1 + [i, j, k]
          eps(i, j, k) = 1.0_wp/(dot_product(cell, [1, 10, 100]) + 1000*s)
          u(:, i, j, k) = cell + [0, 0, s]
        end do
      end do
    end do
    call file%begin_step(0.1_wp*s)
    call file%add('void_fraction', eps, '1')
    call file%add('velocity', u, 'm/s')
    call file%end_step(outcome)
  end subroutine write_gas

  subroutine read_back()
    type(hdf5_file_t) :: file
    type(outcome_t) :: reading

    steps = -1
    counts = 0
    times = -1
    call file%open(folder//'/parcels.vtkhdf', .false.)
    call get_attribute(file, '/VTKHDF/Steps', 'NSteps', steps)
    call get_columns(file, '/VTKHDF/Steps/Values', times, 0_i8)
    call get_columns(file, '/VTKHDF/NumberOfPoints', counts, 0_i8)
    call file%close(reading)
    call expect(.not. reading%failed(), 'the file can be read')
  end subroutine read_back

end program test_vtkhdf
