!> The whole run in one restart file, and back.
!>
!> On the number of ranks that wrote the file, the run goes on bit for bit as if it had not stopped; on another
!> number, to rounding.
module checkpoint
  use gas, only: saved_fields, pace_size
  use kinds, only: wp, i8
  use ledger, only: ledger_t, ledger_from, ledger_size
  use outcome, only: outcome_t, exit_input
  use provenance, only: provenance_t
  use restart_file, only: restart_writer_t, restart_reader_t
  use scene, only: scene_t
  use solids_state, only: solids_state_t, export_state, import_state, n_scalars, n_counts, parcel_rows
  implicit none
  private
  public :: write_checkpoint, read_checkpoint

  character(len=*), parameter :: gas_names(saved_fields) = [character(len=18) :: 'gas_velocity_1', 'gas_velocity_2', &
    'gas_velocity_3', 'gas_pressure', 'void_fraction', 'gas_inlet_1', 'gas_inlet_2', 'gas_inlet_3', 'multigrid_diagonal', &
    'multigrid_upper_1', 'multigrid_upper_2', 'multigrid_upper_3']

  ! Places of the clock's numbers.
  integer, parameter :: clock_size = 7

contains

  subroutine write_checkpoint(name, scene, ledger, origin, outcome)
    character(len=*), intent(in) :: name  !< of the file
    type(scene_t), intent(in) :: scene
    type(ledger_t), intent(in) :: ledger
    type(provenance_t), intent(in) :: origin
    type(outcome_t), intent(inout) :: outcome

    type(restart_writer_t) :: file

    call file%create(name, scene%comm, scene%time, origin)
    call file%add_copy('clock', [scene%time, real(scene%steps, wp), real(scene%halvings, wp), &
                                 real(scene%good_steps, wp), scene%unseen, merge(1.0_wp, 0.0_wp, scene%begun), &
                                 merge(1.0_wp, 0.0_wp, scene%with_gas) + merge(2.0_wp, 0.0_wp, scene%with_parcels)])
    call file%add_copy('ledger', ledger%numbers())
    if (scene%with_gas) call write_gas(file, scene)
    if (scene%with_parcels) call write_solids(file, scene)
    call file%finish(outcome)
  end subroutine write_checkpoint

  subroutine write_gas(file, scene)
    type(restart_writer_t), intent(inout) :: file
    type(scene_t), intent(in) :: scene

    real(wp), allocatable :: fields(:,:,:,:), field(:,:,:)
    real(wp) :: pace(pace_size)
    integer :: i

    associate (n => scene%boxes%n)
      allocate (fields(saved_fields, n(1), n(2), n(3)))
    end associate
    call scene%gas%export_state(fields, pace)
    call file%add_copy('multigrid_pace', pace)
    do i = 1, saved_fields
      field = fields(i, :, :, :)
      call file%add_field(trim(gas_names(i)), field, scene%boxes%lo, scene%boxes%cells)
    end do
    if (any(scene%gas%driving%held)) call file%add_copy('periodic_pressure_drop', scene%gas%driving%drop)
  end subroutine write_gas

  subroutine write_solids(file, scene)
    type(restart_writer_t), intent(inout) :: file
    type(scene_t), intent(in) :: scene

    type(solids_state_t) :: state

    call export_state(scene%solids, state)
    call file%add_copy('solids', [state%scalars, real(state%counts, wp)])
    call file%add_copy('tile_owner', state%owner)
    if (allocated(state%least)) call file%add_copy('least', [state%least])
    call file%add('parcels', state%parcels)
    call file%add('parcel_labels', state%labels)
    call file%add('contact_partner', state%partner)
    call file%add('contact_slip', state%slip)
  end subroutine write_solids

  !> Put a scene, created for the same case and still empty, into the state of a file.
  subroutine read_checkpoint(name, scene, ledger, outcome)
    character(len=*), intent(in) :: name
    type(scene_t), intent(inout) :: scene
    type(ledger_t), intent(inout) :: ledger
    type(outcome_t), intent(inout) :: outcome

    type(restart_reader_t) :: file
    real(wp), allocatable :: clock(:), books(:)

    call file%open(name, scene%comm, outcome)
    if (outcome%failed()) return
    call file%get_copy('clock', clock)
    call file%get_copy('ledger', books)
    if (size(clock) == clock_size .and. size(books) == ledger_size) then
      call set_clock(scene, clock, outcome)
      ledger = ledger_from(books)
    else
      call outcome%fail(exit_input, "'"//name//"' does not hold a run of this program")
    end if
    if (.not. outcome%failed() .and. scene%with_gas) call read_gas(file, scene, name, outcome)
    if (.not. outcome%failed() .and. scene%with_parcels) call read_solids(file, scene, outcome)
    call file%close(outcome)
  end subroutine read_checkpoint

  subroutine set_clock(scene, clock, outcome)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: clock(clock_size)
    type(outcome_t), intent(inout) :: outcome

    integer :: phases

    scene%time = clock(1)
    scene%steps = nint(clock(2), i8)
    scene%halvings = min(nint(clock(3)), scene%limits%deepest)
    scene%good_steps = nint(clock(4))
    scene%unseen = clock(5)
    scene%begun = clock(6) > 0.5_wp
    phases = merge(1, 0, scene%with_gas) + merge(2, 0, scene%with_parcels)
    if (phases /= nint(clock(7))) then
      call outcome%fail(exit_input, 'the case and its restart file do not both have a gas, or parcels')
    end if
  end subroutine set_clock

  subroutine read_gas(file, scene, name, outcome)
    type(restart_reader_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    character(len=*), intent(in) :: name
    type(outcome_t), intent(inout) :: outcome

    real(wp), allocatable :: fields(:,:,:,:), field(:,:,:), pace(:), drop(:)
    integer :: i

    if (any(file%field_shape(trim(gas_names(1))) /= scene%boxes%cells)) then
      call outcome%fail(exit_input, "the case has other gas cells than the restart file '"//name//"'")
      return
    end if
    associate (n => scene%boxes%n)
      allocate (fields(saved_fields, n(1), n(2), n(3)), field(n(1), n(2), n(3)))
    end associate
    do i = 1, saved_fields
      field = 0
      call file%get_field(trim(gas_names(i)), field, scene%boxes%lo)
      fields(i, :, :, :) = field
    end do
    call file%get_copy('multigrid_pace', pace)
    call scene%gas%import_state(fields, pace)
    if (.not. any(scene%gas%driving%held)) return
    if (.not. file%has('periodic_pressure_drop')) return
    call file%get_copy('periodic_pressure_drop', drop)
    scene%gas%driving%drop = drop
  end subroutine read_gas

  subroutine read_solids(file, scene, outcome)
    type(restart_reader_t), intent(inout) :: file
    type(scene_t), intent(inout) :: scene
    type(outcome_t), intent(inout) :: outcome

    type(solids_state_t) :: state
    real(wp), allocatable :: numbers(:), least(:)
    integer :: contacts

    call file%get_copy('solids', numbers)
    if (size(numbers) /= n_scalars + n_counts) then
      call outcome%fail(exit_input, 'the restart file holds other numbers of the parcels than this program writes')
      return
    end if
    call file%get_copy('tile_owner', state%owner)
    if (file%has('least')) then
      call file%get_copy('least', least)
      state%least = reshape(least, [2, size(least)/2])
    end if
    call file%get('parcels', state%parcels)
    call file%get('parcel_labels', state%labels)
    if (size(state%parcels, 1) /= parcel_rows(scene%with_gas)) then
      call outcome%fail(exit_input, 'the restart file holds other values of a parcel than this case needs')
      return
    end if
    contacts = int(sum(state%labels(3, :)))
    call file%get('contact_partner', state%partner, columns=contacts)
    call file%get('contact_slip', state%slip, columns=contacts)
    if (size(state%slip, 1) /= scene%solids%history%rows) then
      call outcome%fail(exit_input, 'the restart file is of a run with a rolling spring, or this case is: both or none must be')
      return
    end if
    state%scalars = numbers(:n_scalars)
    state%counts = nint(numbers(n_scalars + 1:n_scalars + n_counts), i8)
    call import_state(scene%solids, state, outcome)
  end subroutine read_solids

end module checkpoint
